"""Welds of many kinds on sheets of many finishes, as height fields, shaded fast without ray tracing.

The second renderer: it shares no weld model, no surface and no light transport with `synth.camera`, so that
what a network learns from both does not depend on one of them.
"""
