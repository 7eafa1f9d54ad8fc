"""Names of ODE's settings, which can be read where ODE is not installed."""

WHOLE_NUMBERS = frozenset({"QuickStepNumIterations", "AutoDisableFlag"})
_REAL_NUMBERS = frozenset(
    {
        "ERP",
        "CFM",
        "QuickStepW",
        "ContactMaxCorrectingVel",
        "ContactSurfaceLayer",
        "LinearDamping",
        "AngularDamping",
        "AutoDisableLinearThreshold",
        "AutoDisableAngularThreshold",
    }
)
KNOBS = WHOLE_NUMBERS | _REAL_NUMBERS
"""Numbers of a world that a profile may set: ``dWorldSet...`` sets one, ``dWorldGet...`` returns it."""
