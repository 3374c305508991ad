"""What a part reports reaches the operator."""

from boat_rig import Rig

from companion.core.readings import GnssFix
from companion.core.status_text import Severity, StatusText
from companion.hal.background import BackgroundSensor


def test_a_message_of_a_driver_is_sent_to_the_stations_once() -> None:
    gnss = BackgroundSensor[GnssFix](lambda: 1.0, "gnss", lambda: 0.0)
    rig = Rig(gnss=gnss)
    rig.run(0.5)
    gnss.notify(Severity.WARNING, "GNSS: no answer")
    rig.run(0.5)
    assert rig.peer.texts.count("GNSS: no answer") == 1


def test_messages_that_nobody_takes_are_bounded_and_the_newest_stay() -> None:
    gnss = BackgroundSensor[GnssFix](lambda: 1.0, "gnss", lambda: 0.0)
    for number in range(100):
        gnss.notify(Severity.WARNING, f"{number}")
    assert gnss.take_texts()[-1] == StatusText(Severity.WARNING, "99")
    assert gnss.take_texts() == []
