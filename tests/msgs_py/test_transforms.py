import numpy as np
import pinocchio as pin
import pytest

from space_robot_description.load import load_robot
from space_robot_description.share import shipped
from space_robot_msgs_py.codec.codecs import StateCodec
from space_robot_msgs_py.codec.generic import parse
from space_robot_msgs_py.interfaces import RobotState
from space_robot_msgs_py.log.reader import LogReader
from space_robot_msgs_py.log.writer import LogSink
from space_robot_msgs_py.topics import TF, TF_STATIC
from space_robot_msgs_py.transforms import FrameTransforms
from tests.support import values
from tests.support.nonempty import nonempty

SLIDER = """<robot name="slider">
  <link name="base_link"/><link name="rail"/><link name="cart"/>
  <joint name="mount" type="fixed"><origin xyz="1 2 3" rpy="0.3 -0.4 0.5"/><parent link="base_link"/>
    <child link="rail"/></joint>
  <joint name="slide" type="prismatic"><origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><axis xyz="2 0 0"/>
    <parent link="rail"/><child link="cart"/></joint>
</robot>"""


def state_of(rng, n, stamp=100_000_000):
    q = rng.normal(size=7 + n)
    q[3:7] /= np.linalg.norm(q[3:7])
    return RobotState(stamp, q, rng.normal(size=6 + n), rng.normal(size=n), rng.normal(size=3))


def chain(*messages):
    """Parent and placement by child frame."""
    transforms = [t for topic, raw in messages if raw for t in parse(topic.type, raw).transforms]
    found = {}
    for one in transforms:
        shift, turn = one.transform.translation, one.transform.rotation
        rotation = pin.Quaternion(turn.w, turn.x, turn.y, turn.z)
        found[one.child_frame_id] = (
            one.header.frame_id,
            pin.SE3(rotation.matrix(), np.array([shift.x, shift.y, shift.z])),
        )
    return found


def placed(frames, name):
    placement = pin.SE3.Identity()
    while name != "inertial":
        name, step = frames[name]
        placement = step * placement
    return placement


def test_a_quaternion_turns_a_frame_as_its_angles_do():
    """``quat_xyzw`` of URDF 1.1 places a link, of whatever length it is; zeros place none."""
    turned = SLIDER.replace('rpy="0 0 1.5707963267948966"', 'quat_xyzw="0 0 2 2"')
    state = state_of(np.random.default_rng(2), 1)
    here, there = (chain((TF, FrameTransforms(text, ("slide",)).of(state))) for text in (SLIDER, turned))
    assert here["cart"][1].isApprox(there["cart"][1], 1e-12)
    assert FrameTransforms(turned.replace("0 0 2 2", "0 0 0 0"), ("slide",)).of(state) is None


@pytest.mark.parametrize("name", shipped("robots"))
def test_every_link_stands_where_pinocchio_puts_it(name):
    """The chain of transforms gives the placement of every link of every shipped robot."""
    robot = load_robot(name)
    state = state_of(np.random.default_rng(1), robot.n)
    frames = FrameTransforms(robot.urdf, robot.joint_names)
    found = chain((TF, frames.of(state)), (TF_STATIC, frames.static))
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, state.q)
    links = [frame for frame in robot.model.frames if frame.type == pin.FrameType.BODY]
    assert {link.name for link in links} <= found.keys()
    for link in nonempty(links):
        expected = data.oMf[robot.model.getFrameId(link.name, pin.FrameType.BODY)]
        assert placed(found, link.name).isApprox(expected, 1e-12), link.name


def test_prismatic_joints_slide():
    """A prismatic joint moves its link along the unit axis of its own frame, and the mount stays where it is."""
    frames = FrameTransforms(SLIDER, ("slide",))
    q = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.25])
    found = chain((TF, frames.of(RobotState(0, q, np.zeros(7), np.zeros(1), np.zeros(3)))), (TF_STATIC, frames.static))
    assert found["rail"][0] == "base_link"
    np.testing.assert_allclose(found["cart"][1].translation, [0.0, 0.25, 1.0], atol=1e-15)
    np.testing.assert_allclose(found["rail"][1].rotation, pin.rpy.rpyToMatrix(0.3, -0.4, 0.5), atol=1e-15)


def test_messages_and_values_give_the_same_bytes():
    """Made from the recorded messages or from the state itself, the transforms have the same bits."""
    frames, state = FrameTransforms(SLIDER, ("slide",)), state_of(np.random.default_rng(2), 1)
    odometry, joints, _ = StateCodec(("slide",)).encode(state)
    assert frames.from_messages(odometry, joints) == frames.of(state) is not None


@pytest.mark.parametrize("urdf", ["", "no XML", "<robot/>", "<robot><link name='a'/><link name='b'/></robot>"])
def test_a_urdf_without_one_root_has_no_frames(urdf):
    """A text without one root link gives no transforms, and no error."""
    frames = FrameTransforms(urdf, ("slide",))
    assert frames.static is None
    assert frames.of(state_of(np.random.default_rng(3), 1)) is None


def test_numbers_that_are_none_make_no_transform():
    """A state with a NaN in its messages gets no transform; a message of another robot neither."""
    frames, state = FrameTransforms(SLIDER, ("slide",)), state_of(np.random.default_rng(4), 1)
    odometry, joints, _ = StateCodec(("slide",)).encode(state)
    spoilt = joints.replace(state.joints.tobytes(), np.array([np.nan]).tobytes())
    assert spoilt != joints
    assert frames.from_messages(odometry, spoilt) is None
    assert frames.from_messages(odometry, odometry) is None
    assert frames.from_messages(None, joints) is None


def test_the_log_has_them_beside_its_ticks(tmp_path):
    """A log holds one /tf per state and one /tf_static, at their stamps, and its ticks are read as without them."""
    header = values.LogHeader("", SLIDER, 0, ("slide",), topics=values.HEADER.topics)
    ticks = values.run_ticks(4, n=1)
    sink = LogSink(tmp_path / "run", header)
    for tick in ticks:
        sink.record(tick)
    sink.close("completed")
    reader = LogReader(tmp_path / "run")
    stamps = {name: [at for topic, at, _ in reader.messages() if topic == name] for name in ("/tf", "/tf_static")}
    assert stamps == {"/tf": [tick.stamp for tick in ticks], "/tf_static": [0]}
    assert [values.bits(tick) for tick in reader.ticks()] == [values.bits(tick) for tick in ticks]
