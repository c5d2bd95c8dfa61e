# SPDX-License-Identifier: GPL-3.0-or-later
"""The structs of the core's headers as ctypes, member by member.

Before version 1 of libcautery-core they are those of one minor version alone. tests/clients/python_core/layout_test.py
compares them with what a compiler makes of the headers.
"""

from __future__ import annotations

from ctypes import (CFUNCTYPE, POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_float, c_int, c_int32, c_int64,
                    c_size_t, c_uint8, c_uint32, c_uint64, c_void_p)

NAME_BYTES, TEXT_BYTES, MAX_LAYERS, MAX_VESSELS, VESSEL_POINTS = 49, 256, 12, 8, 64
STATUSES = ("ok", "bad_value", "bad_syntax", "bad_mesh", "bad_state", "not_found", "already_exists", "limit",
            "unsupported", "no_memory", "io", "numerical", "faulted", "corrupt")
SHAPES = ("sphere", "capsule", "hook", "spatula", "bipolar", "shears", "grasper")
LAYER_KINDS = ("fascia", "membrane", "fat", "links")
INSTRUCTION_SETS = ("baseline", "avx2", "avx512")
STAGES = ("commands", "predict", "local", "global", "contact", "heat", "dissect", "frame")
# Each scalar of a frame in order, and the bit by which it is watched.
SCALARS = {"exposure": 1 << 2, "charring": 1 << 3, "stress": 1 << 4, "temperature": 1 << 7, "blood": 1 << 9}
TOOL_SIZES = ("hot_radius_m", "tip_length_m", "shaft_radius_m", "shaft_length_m", "jaw_open_rad", "temperature_c",
              "grid_cells", "grid_step_m", "diffusivity_m2_s", "max_speed_m_s", "max_turn_rad_s", "friction",
              "drag_ns_m", "grasp_stiffness_n_m", "slip_force_n", "force_max_n", "close_force_n", "power_w", "peak_v", "crest_factor",
              "current_max_a", "force_filter_s", "blade_heat_j_k", "blade_cooling_w_k", "load_rise_off")


class Error(Structure):
    """cau_error"""

    _fields_ = [("status", c_int), ("file", c_char * 256), ("path", c_char * 160), ("reason", c_char * 320)]


class BuildBorder(Structure):
    """cau_build_border"""

    _fields_ = [("next", c_int), ("vertex_count", c_int64), ("element_count", c_int64), ("factor_entries", c_int64),
                ("bytes", c_size_t)]


BORDER = CFUNCTYPE(c_int, c_void_p, POINTER(BuildBorder), POINTER(Error))


class SessionDef(Structure):
    """cau_session_def"""

    _fields_ = [("scene", c_void_p), ("thread_count", c_int32), ("command_capacity", c_int32), ("unsettled", c_bool),
                ("border", BORDER), ("user", c_void_p), ("instruction_set", c_char_p)]


class SessionLayer(Structure):
    """cau_session_layer"""

    _fields_ = [("name", c_char * NAME_BYTES), ("kind", c_int32), ("first_face", c_int32), ("face_count", c_int32),
                ("element_count", c_int32)]


class SessionInfo(Structure):
    """cau_session_info"""

    _fields_ = [("name", c_char * NAME_BYTES), ("description", c_char * TEXT_BYTES), ("step_s", c_double),
                ("vertex_count", c_int32), ("face_count", c_int32), ("triangle_count", c_int32),
                ("tetrahedron_count", c_int32), ("link_count", c_int32), ("hinge_count", c_int32),
                ("edge_count", c_int32), ("layer_count", c_int32), ("layers", SessionLayer * MAX_LAYERS),
                ("face", c_void_p), ("face_layer", c_void_p), ("rest_position", c_void_p), ("texture", c_void_p),
                ("tetrahedron", c_void_p), ("link", c_void_p), ("instruction_set", c_char_p),
                ("mesh_report", c_void_p)]


class Pose(Structure):
    """cau_pose"""

    _fields_ = [("position_m", c_double * 3), ("rotation", c_double * 4)]


class ToolDef(Structure):
    """cau_tool_def"""

    _fields_ = [("name", c_char * NAME_BYTES), ("shape", c_int), *((name, c_double) for name in TOOL_SIZES),
                ("pose", Pose)]


class ToolState(Structure):
    """cau_tool_state"""

    _fields_ = [("name", c_char * NAME_BYTES), ("definition", ToolDef), ("pose", Pose), ("jaw", c_double),
                ("energized", c_bool), ("grasping", c_bool), ("slipping", c_bool), ("grasped_vertices", c_int32),
                ("contact_vertices", c_int32), ("touched_layers", c_int32), ("force_n", c_double * 3),
                ("torque_nm", c_double * 3), ("raw_force_n", c_double * 3), ("raw_torque_nm", c_double * 3),
                ("tip_temperature_c", c_double), ("energy_j", c_double), ("sequence", c_uint64), ("asked_pose", Pose),
                ("slips", c_int32), ("unused", c_int32), ("asked_jaw", c_double), ("jaw_force_n", c_double),
                ("delivered_w", c_double), ("load_ohm", c_double)]


class Statistics(Structure):
    """cau_statistics"""

    _fields_ = [("seconds", c_double * len(STAGES)), ("iterations", c_int32), ("residual", c_double),
                ("backtracks", c_int32), ("inverted", c_int32), ("long_inverted", c_int32 * MAX_LAYERS),
                ("edges_parted", c_int32), ("elements_removed", c_int32), ("elements_torn", c_int32), ("pending_downdates", c_int32),
                ("deferred_max_s", c_double), ("refactorisations", c_int32), ("factor_operations", c_int32),
                ("contacts", c_int32), ("contacts_left_out", c_int32), ("touching_cut_short", c_int32),
                ("frozen_vertices", c_int32), ("energy_gain_j", c_double),
                ("energy_scale_j", c_double), ("error", c_double), ("resting", c_bool)]


class VesselPoint(Structure):
    """cau_vessel_point"""

    _fields_ = [("position_m", c_float * 3), ("open", c_float)]


class VesselState(Structure):
    """cau_vessel_state"""

    _fields_ = [("name", c_char * NAME_BYTES), ("flags", c_uint32), ("radius_m", c_double), ("bleeding_m3_s", c_double),
                ("shed_m3", c_double), ("burst_pa", c_double), ("point_count", c_int32),
                ("point", VesselPoint * VESSEL_POINTS)]


class Frame(Structure):
    """cau_frame"""

    _fields_ = [("tick", c_uint64), ("time_s", c_double), ("position", c_void_p), ("velocity", c_void_p),
                ("moved_count", c_int32), ("moved", c_void_p), ("face_mask", c_void_p),
                ("mask_changed_count", c_int32), ("mask_changed", c_void_p), ("vertex_visible", c_void_p),
                ("scalar", c_void_p * len(SCALARS)), ("tool_count", c_int32), ("tools", POINTER(ToolState)),
                ("vessel_count", c_int32), ("vessels", POINTER(VesselState) * MAX_VESSELS),
                ("contacts", c_void_p), ("refusal_count", c_int32), ("refusals", POINTER(Error)), ("statistics", Statistics)]


# The struct of each class in the headers.
C_NAMES: dict[type[Structure], str] = {
    Error: "cau_error", BuildBorder: "cau_build_border", SessionDef: "cau_session_def",
    SessionLayer: "cau_session_layer", SessionInfo: "cau_session_info", Pose: "cau_pose", ToolDef: "cau_tool_def",
    ToolState: "cau_tool_state", Statistics: "cau_statistics", VesselPoint: "cau_vessel_point",
    VesselState: "cau_vessel_state", Frame: "cau_frame"}

# The numbers behind the pointers that the package reads.
FLOATS, DOUBLES, INTS, WORDS, BYTES = c_float, c_double, c_int32, c_uint32, c_uint8

_SESSION, _ERROR = c_void_p, POINTER(Error)
# Each function that the package calls: what it returns, and its parameters.
FUNCTIONS: dict[str, tuple[object, list[object]]] = {
    "cau_core_version": (c_char_p, []),
    "cau_default_session_def": (SessionDef, []),
    "cau_session_from_file": (c_int, [c_char_p, POINTER(SessionDef), POINTER(_SESSION), _ERROR]),
    "cau_session_from_json": (c_int, [c_char_p, c_char_p, c_size_t, c_char_p, POINTER(SessionDef), POINTER(_SESSION),
                                      _ERROR]),
    "cau_session_destroy": (None, [_SESSION]),
    "cau_session_describe": (None, [_SESSION, POINTER(SessionInfo)]),
    "cau_session_frame": (None, [_SESSION, POINTER(Frame)]),
    "cau_session_submit_json": (c_int, [_SESSION, c_char_p, c_size_t, _ERROR]),
    "cau_session_step": (c_int, [_SESSION, _ERROR]),
    "cau_session_set_threads": (None, [_SESSION, c_int32]),
    "cau_session_watch": (None, [_SESSION, c_uint32]),
    "cau_session_share": (c_size_t, [_SESSION]),
    "cau_session_snapshot_bytes": (c_size_t, [_SESSION]),
    "cau_session_snapshot": (c_int, [_SESSION, c_void_p, c_size_t, POINTER(c_size_t), _ERROR]),
    "cau_session_restore": (c_int, [_SESSION, c_char_p, c_size_t, POINTER(c_bool), _ERROR]),
    "cau_session_hash": (c_uint64, [_SESSION]),
}
