"""What a case must satisfy beyond the types of its keys; run when a case is loaded."""
