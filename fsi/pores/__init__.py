"""Pore elements: the fluid between discs cut along its necks into pores."""
