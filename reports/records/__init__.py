"""The data model: what a trial leaves behind, and the folder it is kept in."""
