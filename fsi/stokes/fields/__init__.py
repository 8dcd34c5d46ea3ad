"""The flow as fields: values at nodes, rates of strain, tractions, their files."""
