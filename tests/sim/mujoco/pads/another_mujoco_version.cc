// Preloaded, it makes MuJoCo report version 4.0.2.
extern "C" int mj_version() { return 4000002; }
