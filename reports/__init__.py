"""From raw records to tables; reads what trials left behind and never runs one."""
