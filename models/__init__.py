"""The learning room: trains, evaluates and releases the networks that the station loads."""
