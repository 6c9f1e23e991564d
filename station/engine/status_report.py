"""Reports the station's state several times per second: alarms to their log, everything to the window."""

import time

from station.camera.reconnecting import ReconnectingCamera
from station.channel.events import StatusEvent
from station.domain import Origin
from station.engine.alarm_log import AlarmLog
from station.engine.health import StationState, alarms
from station.engine.listener import Listener
from station.plc.port import Line

STATUS_S = 0.25
"""Time between two reports."""


class StatusReport:
    """Sender of the reports; it may be called more often than reports are sent."""

    def __init__(
        self,
        *,
        camera: ReconnectingCamera,
        origin: Origin,
        line: Line,
        listener: Listener,
        alarm_log: AlarmLog,
    ) -> None:
        """`origin`: origin of the camera's frames."""
        self._camera, self._origin, self._line = camera, origin, line
        self._listener, self._alarm_log = listener, alarm_log
        self._started_s, self._sent_s = time.monotonic(), 0.0

    def send(self, state: StationState) -> None:
        """Report the state of the station if it is time."""
        now_s = time.monotonic()
        if now_s - self._sent_s < STATUS_S:
            return
        self._sent_s = now_s
        active = alarms(state)
        command_words, status_words = self._line.windows()
        self._alarm_log.set_active(active)
        self._listener.event(
            StatusEvent(
                at_s=now_s,
                started_s=self._started_s,
                camera_there=self._camera.connected,
                camera_message=self._camera.message,
                origin=self._origin,
                alarms=tuple(int(code) for code in active),
                recipe=state.recipe,
                config_crc=state.config_crc,
                service=state.service,
                line=self._line.state(),
                command_words=command_words,
                status_words=status_words,
            )
        )
