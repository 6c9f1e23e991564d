"""Colours, fonts and sizes: the only style sheet. Quiet grey; colour only for what is abnormal or fresh."""

BACKGROUND = "#1e2124"
SURFACE = "#2a2e32"
TEXT = "#e6e8ea"
QUIET = "#a4abb2"
LINE = "#3d4248"
GOOD = "#2fa862"
BAD = "#e0483e"
WARN = "#e0a92e"
TEST = "#4d8fd6"

STYLE = f"""
QWidget {{ background: {BACKGROUND}; color: {TEXT}; font-family: "DejaVu Sans", "Segoe UI", sans-serif; font-size: 15px; }}
QFrame#card {{ background: {SURFACE}; border: 1px solid {LINE}; border-radius: 6px; }}
QFrame#card QLabel {{ background: transparent; }}
QLabel#quiet {{ color: {QUIET}; font-size: 13px; }}
QLabel#value {{ font-size: 22px; font-weight: 600; }}
QPushButton#action {{ background: {SURFACE}; border: 1px solid {LINE}; border-radius: 6px; padding: 12px; font-size: 17px; }}
QPushButton#action:pressed {{ background: {LINE}; }}
QPushButton#action:disabled {{ color: {QUIET}; }}
QLabel#badge {{ background: {TEST}; color: #101214; font-weight: 700; padding: 4px 10px; border-radius: 4px; }}
"""
