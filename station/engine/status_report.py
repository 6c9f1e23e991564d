"""Reports how the station is, several times a second: alarms to their log, everything to the window."""

import time

from station.camera.reconnecting import ReconnectingCamera
from station.channel.events import StatusEvent
from station.domain import Origin
from station.engine.alarm_log import AlarmLog
from station.engine.health import Seen, alarms
from station.engine.listener import Listener
from station.plc.port import Line

STATUS_S = 0.25
"""Time between two reports."""


class StatusReport:
    """Sends what was found of the station; how often it is asked does not matter."""

    def __init__(
        self,
        *,
        camera: ReconnectingCamera,
        origin: Origin,
        line: Line,
        listener: Listener,
        alarm_log: AlarmLog,
    ) -> None:
        """`origin`: where the camera's frames come from."""
        self._camera, self._origin, self._line = camera, origin, line
        self._listener, self._alarm_log = listener, alarm_log
        self._started_s, self._sent_s = time.monotonic(), 0.0

    def send(self, seen: Seen, reloaded_s: float) -> None:
        """Report `seen` if it is time; `reloaded_s`: epoch seconds of the last request to reload settings."""
        now_s = time.monotonic()
        if now_s - self._sent_s < STATUS_S:
            return
        self._sent_s = now_s
        active = alarms(seen)
        command_words, status_words = self._line.windows()
        self._alarm_log.lasting(active)
        self._listener.event(
            StatusEvent(
                at_s=now_s,
                started_s=self._started_s,
                reloaded_s=reloaded_s,
                camera_there=self._camera.there,
                camera_message=self._camera.message,
                origin=self._origin,
                alarms=tuple(int(code) for code in active),
                recipe=seen.recipe,
                config_crc=seen.config_crc,
                service=seen.service,
                line=self._line.state(),
                command_words=command_words,
                status_words=status_words,
            )
        )
