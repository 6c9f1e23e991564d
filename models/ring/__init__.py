"""The ring network, which finds the weld's centre line: how it is trained, written and combined with a second one."""
