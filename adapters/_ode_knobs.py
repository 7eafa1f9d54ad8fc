"""Names of ODE's settings, in a module that needs no installed ODE."""

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
"""Knobs that a profile may have: numbers of a world, with the functions ``dWorldSetNAME`` and ``dWorldGetNAME``."""
