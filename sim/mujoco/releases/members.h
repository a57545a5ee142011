/* What the pads use of MuJoCo: members of mjModel and mjData, constants, structures and functions.
 * In C, because a user's C compiler reads it for a release that slipbench does not know
 * (layout.c). mujoco_library.h makes the accessors of C++ from the same lists.
 *
 * To use one more member or function: add it here, and run tools/plugin/update_layouts.py. */
#ifndef SLIPBENCH_SIM_MUJOCO_RELEASES_MEMBERS_H_
#define SLIPBENCH_SIM_MUJOCO_RELEASES_MEMBERS_H_

/* COUNT(name): an int, since 3.5.0 a 64-bit integer.
 * VALUE(type, name, member): a value. ARRAY(type, name): a pointer to values of this type. */
#define SLIPBENCH_MODEL_MEMBERS(COUNT, VALUE, ARRAY)       \
  COUNT(nv)                                                \
  COUNT(nbody)                                             \
  COUNT(ngeom)                                             \
  COUNT(nsite)                                             \
  COUNT(npair)                                             \
  COUNT(nexclude)                                          \
  COUNT(ntendon)                                           \
  COUNT(nsensor)                                           \
  COUNT(nplugin)                                           \
  VALUE(double, opt_timestep, opt.timestep)                \
  VALUE(int, opt_integrator, opt.integrator)               \
  VALUE(int, opt_solver, opt.solver)                       \
  VALUE(int, opt_iterations, opt.iterations)               \
  VALUE(int, opt_noslip_iterations, opt.noslip_iterations) \
  VALUE(int, opt_disableflags, opt.disableflags)           \
  VALUE(int, opt_enableflags, opt.enableflags)             \
  VALUE(float, vis_map_force, vis.map.force)               \
  ARRAY(int, body_parentid)                                \
  ARRAY(int, body_rootid)                                  \
  ARRAY(int, body_weldid)                                  \
  ARRAY(int, body_treeid)                                  \
  ARRAY(int, body_jntnum)                                  \
  ARRAY(int, body_dofadr)                                  \
  ARRAY(int, body_dofnum)                                  \
  ARRAY(int, dof_parentid)                                 \
  ARRAY(double, dof_damping)                               \
  ARRAY(int, geom_type)                                    \
  ARRAY(int, geom_contype)                                 \
  ARRAY(int, geom_conaffinity)                             \
  ARRAY(int, geom_bodyid)                                  \
  ARRAY(int, geom_dataid)                                  \
  ARRAY(int, geom_group)                                   \
  ARRAY(double, geom_size)                                 \
  ARRAY(int, site_bodyid)                                  \
  ARRAY(double, site_size)                                 \
  ARRAY(double, site_pos)                                  \
  ARRAY(double, site_quat)                                 \
  ARRAY(int, mesh_vertadr)                                 \
  ARRAY(int, mesh_vertnum)                                 \
  ARRAY(int, mesh_faceadr)                                 \
  ARRAY(int, mesh_facenum)                                 \
  ARRAY(float, mesh_vert)                                  \
  ARRAY(int, mesh_face)                                    \
  ARRAY(int, pair_geom1)                                   \
  ARRAY(int, pair_geom2)                                   \
  ARRAY(int, exclude_signature)                            \
  ARRAY(int, tendon_adr)                                   \
  ARRAY(int, tendon_num)                                   \
  ARRAY(int, wrap_type)                                    \
  ARRAY(int, wrap_objid)                                   \
  ARRAY(int, actuator_plugin)                              \
  ARRAY(int, sensor_adr)                                   \
  ARRAY(int, sensor_plugin)                                \
  ARRAY(int, plugin)                                       \
  ARRAY(int, plugin_stateadr)                              \
  ARRAY(int, plugin_statenum)                              \
  ARRAY(int, name_pluginadr)                               \
  ARRAY(char, names)                                       \
  ARRAY(double, tendon_damping)

#define SLIPBENCH_DATA_MEMBERS(VALUE, ARRAY) \
  VALUE(double, time, time)                  \
  ARRAY(double, qvel)                        \
  ARRAY(double, qacc)                        \
  ARRAY(double, qfrc_applied)                \
  ARRAY(double, qfrc_passive)                \
  ARRAY(double, plugin_state)                \
  ARRAY(double, sensordata)                  \
  ARRAY(double, xpos)                        \
  ARRAY(double, xmat)                        \
  ARRAY(double, geom_xpos)                   \
  ARRAY(double, geom_xmat)                   \
  ARRAY(double, site_xpos)                   \
  ARRAY(double, site_xmat)                   \
  ARRAY(double, subtree_com)                 \
  ARRAY(double, cdof)                        \
  ARRAY(double, cvel)

/* The metric of the integrator `discrete` and what its self-test changes; usable since 3.14.0. */
#define SLIPBENCH_METRIC_MODEL_MEMBERS(COUNT) COUNT(nactuator)
#define SLIPBENCH_METRIC_DATA_MEMBERS(VALUE, ARRAY) \
  VALUE(int, efm_active, efm_active)                \
  VALUE(int, nefmcon, nefmcon)                      \
  ARRAY(int, efm_con_ind)                           \
  ARRAY(double, efm_con_val)

/* CONSTANT(name, MuJoCo's name, value): the same in all releases. */
#define SLIPBENCH_MUJOCO_CONSTANTS(CONSTANT)                \
  CONSTANT(disable_constraint, mjDSBL_CONSTRAINT, 1)        \
  CONSTANT(disable_contact, mjDSBL_CONTACT, 16)             \
  CONSTANT(disable_spring, mjDSBL_SPRING, 32)               \
  CONSTANT(disable_damper, mjDSBL_DAMPER, 64)               \
  CONSTANT(disable_filterparent, mjDSBL_FILTERPARENT, 1024) \
  CONSTANT(disable_eulerdamp, mjDSBL_EULERDAMP, 32768)      \
  CONSTANT(euler, mjINT_EULER, 0)                           \
  CONSTANT(runge_kutta, mjINT_RK4, 1)                       \
  CONSTANT(pgs, mjSOL_PGS, 0)                               \
  CONSTANT(body, mjOBJ_BODY, 1)                             \
  CONSTANT(geom, mjOBJ_GEOM, 5)                             \
  CONSTANT(site, mjOBJ_SITE, 6)                             \
  CONSTANT(mesh, mjOBJ_MESH, 10)                            \
  CONSTANT(plane_geom, mjGEOM_PLANE, 0)                     \
  CONSTANT(hfield_geom, mjGEOM_HFIELD, 1)                   \
  CONSTANT(sphere_geom, mjGEOM_SPHERE, 2)                   \
  CONSTANT(capsule_geom, mjGEOM_CAPSULE, 3)                 \
  CONSTANT(ellipsoid_geom, mjGEOM_ELLIPSOID, 4)             \
  CONSTANT(cylinder_geom, mjGEOM_CYLINDER, 5)               \
  CONSTANT(box_geom, mjGEOM_BOX, 6)                         \
  CONSTANT(mesh_geom, mjGEOM_MESH, 7)                       \
  CONSTANT(sdf_geom, mjGEOM_SDF, 8)                         \
  CONSTANT(arrow_geom, mjGEOM_ARROW, 100)                   \
  CONSTANT(site_wrap, mjWRAP_SITE, 3)                       \
  CONSTANT(sensor_plugin, mjPLUGIN_SENSOR, 2)               \
  CONSTANT(passive_plugin, mjPLUGIN_PASSIVE, 4)             \
  CONSTANT(velocity_stage, mjSTAGE_VEL, 2)                  \
  CONSTANT(decor, mjCAT_DECOR, 4)

/* FUNCTION(result, name, parameters), without those whose type differs between releases:
 * mj_fullM (since 3.10.0), mj_arenaAllocByte and mj_effShift (not in any header). */
#define SLIPBENCH_MUJOCO_FUNCTIONS(FUNCTION)                                                                       \
  FUNCTION(int, mj_version, (void))                                                                                \
  FUNCTION(const char*, mj_versionString, (void))                                                                  \
  FUNCTION(const char*, mj_id2name, (const struct mjModel_*, int, int))                                            \
  FUNCTION(int, mj_name2id, (const struct mjModel_*, int, const char*))                                            \
  FUNCTION(const char*, mj_getPluginConfig, (const struct mjModel_*, int, const char*))                            \
  FUNCTION(struct mjModel_*, mj_copyModel, (struct mjModel_*, const struct mjModel_*))                             \
  FUNCTION(void, mj_deleteModel, (struct mjModel_*))                                                               \
  FUNCTION(struct mjData_*, mj_makeData, (const struct mjModel_*))                                                 \
  FUNCTION(void, mj_deleteData, (struct mjData_*))                                                                 \
  FUNCTION(void, mj_fwdPosition, (const struct mjModel_*, struct mjData_*))                                        \
  FUNCTION(void, mj_fwdVelocity, (const struct mjModel_*, struct mjData_*))                                        \
  FUNCTION(void, mj_fwdActuation, (const struct mjModel_*, struct mjData_*))                                       \
  FUNCTION(void, mj_fwdAcceleration, (const struct mjModel_*, struct mjData_*))                                    \
  FUNCTION(void, mj_fwdConstraint, (const struct mjModel_*, struct mjData_*))                                      \
  FUNCTION(void, mj_solveM, (const struct mjModel_*, struct mjData_*, double*, const double*, int))                \
  FUNCTION(void, mj_applyFT,                                                                                       \
           (const struct mjModel_*, struct mjData_*, const double*, const double*, const double*, int, double*))   \
  FUNCTION(void, mju_quat2Mat, (double*, const double*))                                                           \
  FUNCTION(void, mju_error, (const char*, ...))                                                                    \
  FUNCTION(void, mju_warning, (const char*, ...))                                                                  \
  FUNCTION(void, mjv_initGeom, (struct mjvGeom_*, int, const double*, const double*, const double*, const float*)) \
  FUNCTION(void, mjv_connector, (struct mjvGeom_*, int, double, const double*, const double*))                     \
  FUNCTION(const struct mjpPlugin_*, mjp_getPlugin, (const char*, int*))                                           \
  FUNCTION(const struct mjpPlugin_*, mjp_getPluginAtSlot, (int))                                                   \
  FUNCTION(int, mjp_registerPlugin, (const struct mjpPlugin_*))

struct mjModel_;
struct mjData_;
struct mjvGeom_;
struct mjvScene_;
struct mjvOption_;
struct mjpPlugin_;

/* The same bytes as mjpPlugin, in all releases. */
struct SlipbenchPlugin {
  const char* name;
  int nattribute;
  const char* const* attributes;
  int capabilityflags;
  int needstage;
  int (*nstate)(const struct mjModel_* m, int instance);
  int (*nsensordata)(const struct mjModel_* m, int instance, int sensor_id);
  int (*init)(const struct mjModel_* m, struct mjData_* d, int instance);
  void (*destroy)(struct mjData_* d, int instance);
  void (*copy)(struct mjData_* dest, const struct mjModel_* m, const struct mjData_* src, int instance);
  void (*reset)(const struct mjModel_* m, double* plugin_state, void* plugin_data, int instance);
  void (*compute)(const struct mjModel_* m, struct mjData_* d, int instance, int capability_bit);
  void (*advance)(const struct mjModel_* m, struct mjData_* d, int instance);
  void (*visualize)(const struct mjModel_* m, struct mjData_* d, const struct mjvOption_* opt, struct mjvScene_* scn,
                    int instance);
  void* others[6]; /* callbacks of actuators and signed distance functions */
};

/* The first bytes of mjvScene and mjvGeom, in all releases. */
struct SlipbenchScene {
  int maxgeom;
  int ngeom;
  char* geoms; /* of SlipbenchLayout::mjvGeom_size bytes each */
};
struct SlipbenchGeom {
  int unused[4];
  int category;
};

/* One release: offsets in bytes, or -1 for a member that the release lacks. */
struct SlipbenchLayout {
  int version;      /* mjVERSION_HEADER: 337 for 3.3.7, 340 for 3.4.0, then 3005000 for 3.5.0 */
  int sleep_flag;   /* mjENBL_SLEEP; 0: the release lacks it */
  int discrete;     /* mjINT_DISCRETE; -1: the release lacks it or its metric cannot be used */
  int mjvGeom_size; /* bytes */
  int qM;           /* until 3.10.0 */
#define SLIPBENCH_COUNT(name) int name;
#define SLIPBENCH_VALUE(type, name, member) int name;
#define SLIPBENCH_ARRAY(type, name) int name;
  SLIPBENCH_MODEL_MEMBERS(SLIPBENCH_COUNT, SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
  SLIPBENCH_DATA_MEMBERS(SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
  SLIPBENCH_METRIC_MODEL_MEMBERS(SLIPBENCH_COUNT)
  SLIPBENCH_METRIC_DATA_MEMBERS(SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
#undef SLIPBENCH_COUNT
#undef SLIPBENCH_VALUE
#undef SLIPBENCH_ARRAY
};

#endif
