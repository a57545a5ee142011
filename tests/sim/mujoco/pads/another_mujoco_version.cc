// Preloaded, it makes MuJoCo say that it is version 4.0.2.
extern "C" int mj_version() { return 4000002; }
