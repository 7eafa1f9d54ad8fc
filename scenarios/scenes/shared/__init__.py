"""Parts that several scenes share, and changes of a whole scene that the registry makes."""
