"""The only place that opens data files: schema, records, provenance, audit."""
