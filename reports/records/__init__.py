"""The data model: the results of a trial, and the folder that holds them."""
