"""Whether this process is one of several ranks: known before MPI is loaded."""

import os

# Whatever starts ranks tells each which it is: PMI_RANK, PMIX_RANK, OMPI_COMM_WORLD_RANK, PALS_RANKID.
STARTED = any("PMI" in name or "RANK" in name for name in os.environ)
