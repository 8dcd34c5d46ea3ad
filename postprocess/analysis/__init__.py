"""What a run tells: chains, memory of contacts, settling, strain."""
