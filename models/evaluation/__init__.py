"""How good a network is: judged by the station's own code on labelled data, measured, drawn and reported."""
