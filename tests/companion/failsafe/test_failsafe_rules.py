"""Random sequences of troubles, orders and time: whatever comes, the rules of the failsafes hold."""

import math

from boat_rig import FRAME, GOOD_FIX, nav_at
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from msgspec.structs import replace

from companion.boat import TICK_S
from companion.config.boat_config import BoatConfig
from companion.control.gate import Gate
from companion.control.helm import Helm
from companion.core.intent import Drive
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, HeadingReading, HullReading
from companion.core.requests import Arm, ChangeMode, Disarm, GoTo, ManualControl
from companion.core.state import EstimateFault
from companion.core.status_text import Severity
from companion.failsafe.inputs import BoardReadings
from companion.failsafe.monitor import PERIOD_S
from companion.failsafe.motors.hypotheses import HYPOTHESES, Hypothesis
from companion.failsafe.motors.watch import MotorWatch
from companion.failsafe.table import Condition
from companion.guidance.pilot import Pilot
from companion.guidance.stall_detector import StallVerdict
from companion.vehicle.mission.steps import Home, Waypoint
from companion.vehicle.vehicle import Vehicle

FAULTS = st.lists(st.sampled_from(EstimateFault), max_size=3)


class ScriptedMotors(MotorWatch):
    """Says of the motors what the test wants, whatever they do."""

    def reset(self) -> None:
        """Nothing to forget."""

    def pause(self) -> None:
        """Nor here."""

    def update(self, *_: object) -> None:
        """Nothing to learn."""


class Failsafes(RuleBasedStateMachine):
    """A vehicle with its gate, and everything that can be wrong around it."""

    def __init__(self) -> None:
        super().__init__()
        self.config = BoatConfig()
        self.vehicle = Vehicle(self.config)
        self.vehicle.failsafes.motors = self.motors = ScriptedMotors(self.config)
        self.pilot, self.helm, self.gate = Pilot(), Helm(), Gate()
        self.now_s = 0.0
        self.faults = 0
        self.is_stale = False
        self.volt = 12.0
        self.operator_is_there = self.planner_is_there = self.hand_is_there = True
        self.chosen: Mode | None = None  # by the operator, since the last alarm
        self.command = (0.0, 0.0)
        self.reason = ""
        home = FRAME.to_global(nav_at().point)
        there = FRAME.to_global(nav_at(300.0, 100.0).point)
        self.vehicle.set_mission((Home(), Waypoint(there), Waypoint(home)))
        self.pass_time(1.0)

    @rule(faults=FAULTS, is_stale=st.booleans())
    def something_is_wrong_with_the_estimate(self, faults: list[EstimateFault], is_stale: bool) -> None:
        self.faults = sum(set(faults))
        self.is_stale = is_stale

    @rule()
    def all_is_well_with_the_estimate(self) -> None:
        self.faults, self.is_stale = 0, False

    @rule(volt=st.sampled_from((8.0, 10.0, 12.0)))
    def the_pack_changes(self, volt: float) -> None:
        self.volt = volt

    @rule(operator=st.booleans(), planner=st.booleans(), hand=st.booleans())
    def stations_come_and_go(self, operator: bool, planner: bool, hand: bool) -> None:
        self.operator_is_there, self.planner_is_there, self.hand_is_there = operator, planner, hand

    @rule(
        stall=st.sampled_from(StallVerdict),
        is_wet=st.booleans(),
        load=st.sampled_from((0.1, 1.5)),
        roll=st.sampled_from((0.0, 2.0)),
        storage=st.sampled_from(("", "No space left on device")),
        verdict=st.sampled_from((None, *HYPOTHESES)),
    )
    def something_is_wrong_on_board(
        self,
        stall: StallVerdict,
        is_wet: bool,
        load: float,
        roll: float,
        storage: str,
        verdict: Hypothesis | None,
    ) -> None:
        self.vehicle.board = BoardReadings(
            stall=stall,
            load=load,
            storage_fault=storage,
            hull=HullReading(self.now_s, is_wet, 20.0),
            heading=HeadingReading(self.now_s, 0.0, 0.0, roll, 0.0),
        )
        self.motors.verdict = verdict

    @rule(mode=st.sampled_from(Mode))
    def the_operator_chooses_a_mode(self, mode: Mode) -> None:
        if self.vehicle.request(ChangeMode(mode)).accepted:
            self.chosen = mode
        self.read_notices()

    @rule(force=st.booleans())
    def somebody_arms(self, force: bool) -> None:
        self.vehicle.request(Arm(force))
        self.read_notices()

    @rule()
    def somebody_disarms(self) -> None:
        self.vehicle.request(Disarm())
        self.drive()
        assert self.command == (0.0, 0.0)
        self.read_notices()

    @rule()
    def a_planner_steers(self) -> None:
        if self.vehicle.request(GoTo(FRAME.to_global(nav_at(50.0, 50.0).point))).accepted:
            self.vehicle.failsafes.planner.steers(self.now_s)
        self.read_notices()

    @rule(seconds=st.sampled_from((0.2, 3.0, 15.0, 100.0)))
    def pass_time(self, seconds: float) -> None:
        for _ in range(round(seconds / PERIOD_S)):
            self.now_s += PERIOD_S
            self.live()

    def live(self) -> None:
        vehicle = self.vehicle
        nav = nav_at(time_s=self.now_s, age_s=100.0 if self.is_stale else 0.1)
        self.nav = replace(nav, faults=self.faults, current_east_m_s=0.4)
        if self.operator_is_there:
            vehicle.failsafes.operator_heard_s = self.now_s
        if self.planner_is_there:
            vehicle.failsafes.planner.heard(self.now_s)
        battery = BatteryReading(self.now_s, self.volt, 2.0)
        vehicle.update_state(self.nav, FRAME, GOOD_FIX, battery, self.now_s)
        if self.hand_is_there:
            vehicle.request(ManualControl(0.5, 0.2))
        if (hull := vehicle.board.hull) is not None:
            vehicle.board = replace(vehicle.board, hull=replace(hull, time_s=self.now_s))
        active, mode, armed = vehicle.failsafes.active, vehicle.mode, vehicle.armed
        self.drive()
        if vehicle.armed and self.faults & EstimateFault.HEADING_LOST and not self.reason:
            is_blind = vehicle.mode in (Mode.MANUAL, Mode.HOLD) or vehicle.recovery.is_active
            feels = (
                vehicle.mode is Mode.LOITER and isinstance(self.intent, Drive) and not self.intent.steering
            )
            assert is_blind or feels, "steered by a heading that nobody knows"
        fired = Condition(vehicle.failsafes.active & ~active)
        texts = self.read_notices()
        if fired:
            assert any(text.startswith("Failsafe: ") for text in texts), f"{fired!r} was not told"
        if vehicle.mode is not mode or vehicle.armed is not armed:
            assert texts, "a change was not told"
        if self.chosen is not None and vehicle.mode is not self.chosen and mode is self.chosen:
            is_news = any(text.startswith(("Failsafe: ", "Mission complete")) for text in texts)
            assert is_news, "the operator's choice was undone without a word"
            self.chosen = None

    def drive(self) -> None:
        vehicle, nav = self.vehicle, self.nav
        self.intent = intent = vehicle.decide()
        steered = self.pilot.update(intent, nav, self.config, TICK_S)
        thrust = self.helm.update(steered, nav, self.config, TICK_S)
        command = self.gate.check(
            thrust,
            armed=vehicle.armed,
            command_age_s=0.0,
            nav=nav,
            needs_estimate=not isinstance(steered, Drive),
            setting=self.config.motors,
            dt_s=TICK_S,
            needs_position=vehicle.modes.loiter.needs_position,
        )
        self.command, self.reason = (command.left, command.right), command.reason

    def read_notices(self) -> list[str]:
        notices = self.vehicle.take_status_texts()
        assert all(Severity.CRITICAL <= notice.severity <= Severity.INFO for notice in notices)
        assert len(notices) <= 30
        return [notice.text for notice in notices]

    @invariant()
    def a_disarmed_boat_gives_no_thrust(self) -> None:
        assert self.vehicle.armed or self.command == (0.0, 0.0)
        assert self.vehicle.armed or not self.vehicle.recovery.is_active

    @invariant()
    def every_command_is_a_share(self) -> None:
        assert all(math.isfinite(share) and abs(share) <= 1.0 for share in self.command)

    @invariant()
    def the_mode_is_one_that_there_is(self) -> None:
        assert self.vehicle.mode in Mode


TestFailsafes = Failsafes.TestCase
TestFailsafes.settings = settings(max_examples=20, stateful_step_count=20, deadline=None)
