# The workflow is in workflow/Snakefile. Called from here, it finds profiles/default by itself.
include: "workflow/Snakefile"


# A file that is included does not say what is made where nothing is asked for.
workflow.default_target = "all"
