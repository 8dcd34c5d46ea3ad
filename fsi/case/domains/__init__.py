"""The shapes of domains, one file each; a file has the name of its word."""
