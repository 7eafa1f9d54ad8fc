"""The stability extension: makes rigid bodies stack in any engine through contacts, sleep and mass."""
