"""How the rooms become one package to install."""
