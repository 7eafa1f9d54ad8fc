"""Shared parts of the reference engines: the table of boxes, the contact detector, contact rows and the integrator.

A reference engine is written in this repository after a published method. It is compared with products, and is never a
product itself. Its geometry is independent of the judge (``scenarios.statics``) and of the port
(``adapters.shared.box_contacts``), so that its results confirm or contradict both.
"""
