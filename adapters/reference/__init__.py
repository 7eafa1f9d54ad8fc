"""Shared parts of the reference engines: the table of boxes, the contact detector, contact rows and the integrator.

A reference engine is code of this repository after a published method. The suite compares reference engines with
products, but ranks only products. The geometry of reference engines is independent of the judge (``scenarios.statics``)
and of the port (``adapters.shared.box_contacts``), so that their results confirm or contradict both.
"""
