"""Protobuf schemas, the generated module, plausibility checks."""
