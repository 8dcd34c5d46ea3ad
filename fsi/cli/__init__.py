"""The command `fsi`: one module for each command, `fsi.cli.main` runs them."""
