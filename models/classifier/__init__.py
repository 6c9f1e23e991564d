"""The classifier: its network, how it is trained, and the ONNX file with its model card that the station loads."""
