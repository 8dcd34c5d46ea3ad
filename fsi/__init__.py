"""Rigid bodies moving in Stokes flow, resolved down to the lubrication film."""
