"""What is measured of any flow: resistance, bulk stress, identities, error bars."""
