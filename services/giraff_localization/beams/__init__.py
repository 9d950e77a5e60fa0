"""giraff_localization: what each type of sense tells of a floor plan."""
