"""The page Setup: login, camera, recipe, masters, users, journal."""
