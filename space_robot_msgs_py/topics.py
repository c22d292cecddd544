"""The topic table: publishers, subscribers, recorder, replay, QoS and docs derive from it. Standard types only."""

from __future__ import annotations

from space_robot_msgs_py.topic import Kind as Kind
from space_robot_msgs_py.topic import Topic as Topic

# The order of rows is the order of messages of one stamp in the log.
ROBOT_DESCRIPTION = Topic(
    "robot_description",
    "std_msgs/msg/String",
    "description",
    "simulator",
    "URDF of the nominal robot",
    latched=True,
)
BASE_ODOM = Topic(
    "base/odom",
    "nav_msgs/msg/Odometry",
    "state",
    "simulator",
    "measured base pose in `inertial`, twist in `base_link`",
)
JOINT_STATES = Topic(
    "joint_states",
    "sensor_msgs/msg/JointState",
    "state",
    "simulator",
    "measured joint position and velocity; effort is the mean motor effort over the period that ended at the stamp",
)
BASE_IMU = Topic(
    "base/imu",
    "sensor_msgs/msg/Imu",
    "state",
    "simulator",
    "angular rate and inertial acceleration of the base origin in `base_link`, as a sensor reads them",
)
WHEEL_MOMENTUM = Topic(
    "base/wheel_momentum",
    "geometry_msgs/msg/Vector3Stamped",
    "state",
    "simulator",
    "measured momentum of the reaction wheels relative to the base, sum over their axes, in `base_link` [N m s]; in "
    "runs with `plant.sensors.wheel_momentum`",
    optional=True,
)
REFERENCE_BASE = Topic(
    "reference/base",
    "nav_msgs/msg/Odometry",
    "reference",
    "guidance",
    "desired base pose in `inertial`, twist in `base_link_desired`; published ahead, stamped with the tick it is for",
)
REFERENCE_BASE_ACCEL = Topic(
    "reference/base_accel",
    "geometry_msgs/msg/AccelStamped",
    "reference",
    "guidance",
    "derivative of the components of the desired base twist, in `base_link_desired`",
)
REFERENCE_JOINTS = Topic(
    "reference/joints",
    "trajectory_msgs/msg/JointTrajectory",
    "reference",
    "guidance",
    "desired joint position, velocity and acceleration (one point)",
)
CONTROLLER_EVENTS = Topic(
    "controller/events",
    "std_msgs/msg/String",
    "controller_event",
    "controller",
    "gains changed and laws switched during the run, one JSON line each: stamp [ns] of the first command it acts on, "
    "kind, content; sent before that command",
    sporadic=True,
)
EVENTS = Topic(
    "events",
    "diagnostic_msgs/msg/DiagnosticArray",
    "supervision_event",
    "supervisor",
    "what a supervisor found at the stamp: monitors that fire and clear, with value and severity, commands of the "
    "ground, sequences, and changes of mode; sent before the mode",
    sporadic=True,
    optional=True,
)
HOUSEKEEPING = Topic(
    "housekeeping",
    "std_msgs/msg/Float64MultiArray",
    "housekeeping",
    "supervisor",
    "labelled blocks in layout.dim: `stamp` [ns], `mode` (its place in the table), `events` (how many so far), and the "
    "values that the table names; every so many periods",
    sporadic=True,
    optional=True,
)
SUPERVISOR_MODE = Topic(
    "supervisor/mode",
    "diagnostic_msgs/msg/DiagnosticArray",
    "supervision",
    "supervisor",
    "the mode that holds from the stamp on, one status: message is its name, values are `law`, `reference`, `since` "
    "[ns] and `answer` [ns], the age of the newest command it knew of, and where it is so `brakes` (closed are those "
    "of the joints) and `wheels` (thrusters unload them); the controller answers the state when it has it",
    optional=True,
)
WRENCH_COMMAND = Topic(
    "base/wrench_command",
    "geometry_msgs/msg/WrenchStamped",
    "command",
    "controller",
    "force and torque on the base in `base_link`; the stamp is that of the state it answers",
)
JOINT_COMMAND = Topic(
    "joint_command",
    "sensor_msgs/msg/JointState",
    "command",
    "controller",
    "joint effort; the stamp is that of the state it answers",
)
CONTROLLER_TELEMETRY = Topic(
    "controller/telemetry",
    "std_msgs/msg/Float64MultiArray",
    "controller_telemetry",
    "controller",
    "labelled blocks in layout.dim; block `stamp` holds [ns], the rest is the law's own",
)
# Before the telemetry, which every tick ends with: a tick that is there to its end is there as a whole.
FAULTS = Topic(
    "faults",
    "diagnostic_msgs/msg/DiagnosticArray",
    "plant_event",
    "simulator",
    "what begins (level ERROR) and ends (OK) to be wrong with the real robot at the stamp, as the experiment plans it: "
    "the truth, not for the flight software; sent before the state",
    sporadic=True,
    optional=True,
)
PLANT_EVENTS = Topic(
    "plant/events",
    "diagnostic_msgs/msg/DiagnosticArray",
    "plant_event",
    "simulator",
    "commands that were missing, refused or clipped in the period that ended at the stamp (`plant.monitor`), with "
    "channel, value and count; sent before the state",
    sporadic=True,
    optional=True,
)
PLANT_TELEMETRY = Topic(
    "plant/telemetry",
    "std_msgs/msg/Float64MultiArray",
    "plant_telemetry",
    "simulator",
    "labelled blocks: `stamp` [ns], truth, momentum, energy, conservation residuals, wheel momentum, saturation",
)
TF = Topic(
    "/tf",
    "tf2_msgs/msg/TFMessage",
    "tool",
    "simulator",
    "`inertial` to the root link and every moving link in its parent, from the measured state; live only where "
    "tf2_msgs is installed",
    derived=True,
)
TF_STATIC = Topic(
    "/tf_static",
    "tf2_msgs/msg/TFMessage",
    "tool",
    "simulator",
    "links behind fixed joints; live only where tf2_msgs is installed",
    latched=True,
    derived=True,
)
ATTITUDE = Topic(
    "base/attitude_rpy_deg",
    "geometry_msgs/msg/Vector3Stamped",
    "tool",
    "simulator",
    "measured roll, pitch and yaw of the base in `inertial` [deg], for plots; live only where something listens",
    derived=True,
)
REFERENCE_ATTITUDE = Topic(
    "reference/attitude_rpy_deg",
    "geometry_msgs/msg/Vector3Stamped",
    "tool",
    "guidance",
    "desired roll, pitch and yaw of the base in `inertial` [deg], for plots; live only where something listens",
    derived=True,
)
RUN_BEGIN = Topic(
    "run_begin",
    "std_msgs/msg/String",
    "event",
    "simulator",
    "JSON: name of the run, and how often it was reset; time begins again with a reset and with nothing else",
    latched=True,
    recorded=False,
)
RUN_END = Topic(
    "run_end",
    "std_msgs/msg/String",
    "event",
    "simulator",
    "JSON: name of the run, node, and reason why the run ended; every node of that run stops when it hears it",
    latched=True,
    recorded=False,
)
HEARTBEAT = Topic(
    "heartbeat",
    "std_msgs/msg/String",
    "tool",
    "every node",
    "the role of a node whose executor runs, five times a second of the steady clock; only of nodes of a paced run "
    "that were started one by one",
    recorded=False,
    deterministic=False,
)
RECORDER_CREDIT = Topic(
    "recorder/credit",
    "rosgraph_msgs/msg/Clock",
    "event",
    "recorder",
    "how far the simulator may go: the run starts when the recorder is matched with every node, and never outruns it",
    latched=True,
    recorded=False,
)
ACCEPTED_COMMAND = Topic(
    "accepted_command",
    "std_msgs/msg/Float64MultiArray",
    "accepted_command",
    "simulator",
    "the commands the simulator accepted, as blocks `stamp` [ns], `wrench`, `effort`; without numbers: the period of "
    "the stamp had none; with a block `too_late`: it can act no more; of two controllers with a block `acting:NAME`: "
    "the one that answers next, how many states were answered, and the first state of its turn [ns], and with a block "
    "`eventI:LINE` for each event of `controller/events` that belongs to the command. Always in a paced run; in "
    "lock-step only where a node listens, as the recorder does once commands have more than one publisher",
    recorded=False,
)
CLOCK = Topic(
    "/clock",
    "rosgraph_msgs/msg/Clock",
    "tool",
    "simulator",
    "simulation time, for tools only",
    recorded=False,
)
DIAGNOSTICS = Topic(
    "/diagnostics",
    "diagnostic_msgs/msg/DiagnosticArray",
    "tool",
    "simulator",
    "rate, late, missed and refused commands, saturation, residuals, computation time, estimator: all that depends on "
    "the wall clock",
    recorded=False,
    deterministic=False,
)

TABLE: tuple[Topic, ...] = (
    ROBOT_DESCRIPTION,
    BASE_ODOM,
    JOINT_STATES,
    BASE_IMU,
    WHEEL_MOMENTUM,
    REFERENCE_BASE,
    REFERENCE_BASE_ACCEL,
    REFERENCE_JOINTS,
    CONTROLLER_EVENTS,
    EVENTS,
    HOUSEKEEPING,
    SUPERVISOR_MODE,
    WRENCH_COMMAND,
    JOINT_COMMAND,
    CONTROLLER_TELEMETRY,
    FAULTS,
    PLANT_EVENTS,
    PLANT_TELEMETRY,
    TF,
    TF_STATIC,
    ATTITUDE,
    REFERENCE_ATTITUDE,
    RUN_BEGIN,
    RUN_END,
    HEARTBEAT,
    RECORDER_CREDIT,
    ACCEPTED_COMMAND,
    CLOCK,
    DIAGNOSTICS,
)


def topics_of(kind: Kind) -> tuple[Topic, ...]:
    """The rows that carry a value of that kind in every run, in table order."""
    return tuple(topic for topic in TABLE if topic.kind == kind and not topic.optional)
