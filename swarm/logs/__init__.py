"""Reading logs: records, tables, completeness, damage."""
