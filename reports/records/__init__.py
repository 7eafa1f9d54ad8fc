"""The data model: the record, frames and recording of a trial, and the results folder that contains them."""
