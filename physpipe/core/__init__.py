"""L0: numbers and small mechanisms; touches no video, table or model file."""

import os

# Read once, when torch is first imported: threads that spin while they wait take the cores from those they wait for,
# and a training of two threads on a busy machine takes 20 times as long.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
