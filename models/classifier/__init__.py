"""The classifier: its network, its training, and the ONNX file with its model card."""
