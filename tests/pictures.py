"""What is said where pictures cannot be drawn, so that their tests do not vanish in silence."""

NO_PICTURES = "no picture is tested"
