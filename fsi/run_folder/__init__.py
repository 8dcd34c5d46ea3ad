"""The folder of a run: tables, checkpoints, provenance, the files of ParaView."""
