// Made by layouts.py of this folder: do not edit.
// clang-format off
#pragma once

#define SLIPBENCH_MUJOCO_CALLS(X) \
  X(mj_applyFT) \
  X(mj_arenaAllocByte) \
  X(mj_copyModel) \
  X(mj_deleteData) \
  X(mj_deleteModel) \
  X(mj_deleteSpec) \
  X(mj_effShift) \
  X(mj_fullM) \
  X(mj_fwdAcceleration) \
  X(mj_fwdActuation) \
  X(mj_fwdConstraint) \
  X(mj_fwdPosition) \
  X(mj_fwdVelocity) \
  X(mj_getPluginConfig) \
  X(mj_id2name) \
  X(mj_jac) \
  X(mj_makeData) \
  X(mj_name2id) \
  X(mj_solveM) \
  X(mj_version) \
  X(mj_versionString) \
  X(mjp_defaultPlugin) \
  X(mjp_getPlugin) \
  X(mjp_getPluginAtSlot) \
  X(mjp_registerPlugin) \
  X(mju_error) \
  X(mju_quat2Mat) \
  X(mju_user_error) \
  X(mju_user_warning) \
  X(mju_warning) \
  X(mju_zero) \
  X(mjv_connector) \
  X(mjv_initGeom)

#include "tools/program/plugin/any_mujoco.h"

#define mj_applyFT (*slipbench::any_mujoco::calls.mj_applyFT_)
#define mj_arenaAllocByte (*slipbench::any_mujoco::calls.mj_arenaAllocByte_)
#define mj_copyModel (*slipbench::any_mujoco::calls.mj_copyModel_)
#define mj_deleteData (*slipbench::any_mujoco::calls.mj_deleteData_)
#define mj_deleteModel (*slipbench::any_mujoco::calls.mj_deleteModel_)
#define mj_deleteSpec (*slipbench::any_mujoco::calls.mj_deleteSpec_)
#define mj_effShift (*slipbench::any_mujoco::calls.mj_effShift_)
#define mj_fullM (*slipbench::any_mujoco::calls.mj_fullM_)
#define mj_fwdAcceleration (*slipbench::any_mujoco::calls.mj_fwdAcceleration_)
#define mj_fwdActuation (*slipbench::any_mujoco::calls.mj_fwdActuation_)
#define mj_fwdConstraint (*slipbench::any_mujoco::calls.mj_fwdConstraint_)
#define mj_fwdPosition (*slipbench::any_mujoco::calls.mj_fwdPosition_)
#define mj_fwdVelocity (*slipbench::any_mujoco::calls.mj_fwdVelocity_)
#define mj_getPluginConfig (*slipbench::any_mujoco::calls.mj_getPluginConfig_)
#define mj_id2name (*slipbench::any_mujoco::calls.mj_id2name_)
#define mj_jac (*slipbench::any_mujoco::calls.mj_jac_)
#define mj_makeData (*slipbench::any_mujoco::calls.mj_makeData_)
#define mj_name2id (*slipbench::any_mujoco::calls.mj_name2id_)
#define mj_solveM (*slipbench::any_mujoco::calls.mj_solveM_)
#define mj_version (*slipbench::any_mujoco::calls.mj_version_)
#define mj_versionString (*slipbench::any_mujoco::calls.mj_versionString_)
#define mjp_defaultPlugin (*slipbench::any_mujoco::calls.mjp_defaultPlugin_)
#define mjp_getPlugin (*slipbench::any_mujoco::calls.mjp_getPlugin_)
#define mjp_getPluginAtSlot (*slipbench::any_mujoco::calls.mjp_getPluginAtSlot_)
#define mjp_registerPlugin (*slipbench::any_mujoco::calls.mjp_registerPlugin_)
#define mju_error (*slipbench::any_mujoco::calls.mju_error_)
#define mju_quat2Mat (*slipbench::any_mujoco::calls.mju_quat2Mat_)
#define mju_user_error (*slipbench::any_mujoco::calls.mju_user_error_)
#define mju_user_warning (*slipbench::any_mujoco::calls.mju_user_warning_)
#define mju_warning (*slipbench::any_mujoco::calls.mju_warning_)
#define mju_zero (*slipbench::any_mujoco::calls.mju_zero_)
#define mjv_connector (*slipbench::any_mujoco::calls.mjv_connector_)
#define mjv_initGeom (*slipbench::any_mujoco::calls.mjv_initGeom_)
#undef mjDSBL_SPRING
#define mjDSBL_SPRING slipbench::any_mujoco::number(slipbench::any_mujoco::DSBL_SPRING_number)
#undef mjDSBL_DAMPER
#define mjDSBL_DAMPER slipbench::any_mujoco::number(slipbench::any_mujoco::DSBL_DAMPER_number)
#undef mjDSBL_EULERDAMP
#define mjDSBL_EULERDAMP slipbench::any_mujoco::number(slipbench::any_mujoco::DSBL_EULERDAMP_number)
#undef mjDSBL_FILTERPARENT
#define mjDSBL_FILTERPARENT slipbench::any_mujoco::number(slipbench::any_mujoco::DSBL_FILTERPARENT_number)
#undef mjENBL_SLEEP
#define mjENBL_SLEEP slipbench::any_mujoco::number(slipbench::any_mujoco::ENBL_SLEEP_number)
