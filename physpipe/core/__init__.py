"""L0: numbers and small mechanisms; touches no video, table or model file."""
