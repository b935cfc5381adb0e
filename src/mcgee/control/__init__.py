"""Laws of control."""
