"""Arrays of contacts and motions for the ports and for the suite's adapters."""
