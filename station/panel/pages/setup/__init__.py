"""Behind a login: camera, recipe, masters, users, journal."""
