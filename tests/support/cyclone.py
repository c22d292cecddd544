"""A client of another DDS implementation, Eclipse Cyclone DDS, without anything of ROS: types written down by hand."""

# No annotations that are texts: the types of the fields are read from them.
from dataclasses import dataclass
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration

# What finds nodes that are on this host only (ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST): peers in place of multicast.
CONFIGURATION = """<CycloneDDS><Domain>
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
<Peers><Peer address="localhost"/></Peers></Discovery>
</Domain></CycloneDDS>"""


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Wrench(IdlStruct, typename="geometry_msgs::msg::dds_::Wrench_"):
    force: Vector3
    torque: Vector3


@dataclass
class WrenchStamped(IdlStruct, typename="geometry_msgs::msg::dds_::WrenchStamped_"):
    header: Header
    wrench: Wrench


@dataclass
class JointState(IdlStruct, typename="sensor_msgs::msg::dds_::JointState_"):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


class CycloneClient:
    """Answers every joint state with the same effort at every joint.

    Args:
        domain: number of it.
        effort: [N m or N].
    """

    def __init__(self, domain: int, effort: float) -> None:
        self._effort, self.answered = effort, list[int]()
        # The first participant of a domain takes the configuration; it is kept as long as the client.
        self._domain = Domain(domain, CONFIGURATION)
        participant = DomainParticipant(domain)
        qos = Qos(
            Policy.Reliability.Reliable(duration(seconds=1)),
            Policy.History.KeepLast(10),
            Policy.DataRepresentation(use_cdrv0_representation=True),
        )

        def topic(name: str, kind: Any) -> Any:
            return Topic(participant, f"rt/{name}", kind)

        self._states = DataReader(Subscriber(participant), topic("joint_states", JointState), qos=qos)
        self._wrench = DataWriter(Publisher(participant), topic("base/wrench_command", WrenchStamped), qos=qos)
        self._joints = DataWriter(Publisher(participant), topic("joint_command", JointState), qos=qos)

    def answer(self) -> None:
        """Take what is there, and answer it."""
        still = Vector3(0.0, 0.0, 0.0)
        # The first take has samples that only say that a writer came.
        for state in (one for one in self._states.take(100) if isinstance(one, JointState)):
            stamp = state.header.stamp
            self.answered.append(stamp.sec * 1_000_000_000 + stamp.nanosec)
            self._wrench.write(WrenchStamped(Header(stamp, "base_link"), Wrench(still, still)))
            self._joints.write(JointState(Header(stamp, ""), state.name, [], [], [self._effort] * len(state.name)))
