"""Values at which an identification decides about the sheet, about its law, or whether to believe what it found."""

# Which of two candidates is kept.
#: Gain of a score from which one more material or term is kept: odds of 20 to 1.
EVIDENCE = 3.0
#: Logarithm of the likelihood that another law may lack and still be no worse: two standard deviations of one number.
AS_WELL = 2.0
#: What changed labels of cells must lower the cost by: less is chance.
CHANGED_CELLS_GAIN = 0.5

# What is left, and whether it is noise.
#: Standard deviations of what is known of noise, beyond which nothing is left by chance.
BY_CHANCE = 3.0
#: Standard deviations by which the misfit never falls short of known noise. A field has parameters, so that by two it
#: does.
NEVER_SO_LITTLE = 5.0
#: Misfit of displacements over their noise of which three quarters of the squares are no noise.
MOSTLY_NO_NOISE = 2.0
#: What one material leaves of a load step, over noise, from which the step tells where materials are.
FAR_FROM_NOISE = 5.0
#: Share of the cost that misfits without noise have where the terms do not contain the material; else hundredths.
MUCH_LEFT = 0.3
#: Share of the cost below which misfits leave nothing to explain: of neo-Hookean sheets it is a few thousandths.
NOTHING_LEFT = 0.02
#: A displacement misfit this close to its noise counts as explained.
EXPLAINED = 1.05

# What the sheet is made of.
#: Standard deviations between two materials, or between a term and none, from which they are not tried as one. Three
#: are no chance, and what elements miss makes a few times as much.
APART = 10.0
#: Ratio of what few materials leave to what a factor in every cell leaves, from which the sheet is not made of them.
NOT_MADE_OF_FEW = 3.0
#: Ratio of what whole cells leave to what the lines around them leave, up to which single cells may be wrong. Under
#: noise the few that a line misplaces hardly show.
NEARLY = 1.2
#: Parts of fewer touching cells are none: a line around less cannot be told from noise.
FEWEST_CELLS = 3
#: Regions of fewer nodes than a cell's are none.
FEWEST_NODES = 4

# What is believed of noise and window.
#: Noise rules from this share of the assumed error of the description on; from all of it where nothing explains.
NOISE_RULES = 0.25
#: Ratio of what is left to the believed noise, or the other way round, beyond which that is told anew.
NOISE_KNOWN = 1.1
#: Correlation of what different steps leave, up to which it is noise: a shared reference picture makes a half.
NOISE_SHARED = 0.6
#: Side of a window, in points, below which it changes less than points apart do, and is none.
NO_WINDOW = 0.5

# Whether the answer explains the test.
#: Misfit of displacements over their uncertainty beyond which a test is not explained.
UNEXPLAINED = 2.0
#: The same of forces.
FORCES_UNEXPLAINED = 2.5
#: How far finite elements describe forces, over them, on their own grid: those of good fields are missed by a
#: thousandth.
FORCES_DESCRIBED = 2.4e-3
#: The same where the grid is another one. Of sheets that are not of our making the terms follow no law to better than
#: half a hundredth.
LAWS_DESCRIBED = 5e-3
#: Misfit of the forces of one load case by the closest homogeneous material beyond which no sheet can have given
#: them. Ogden, Gent and Fung sheets are missed by 7 % at most, heterogeneous ones by 3 %. A record that is constant by
#: a quarter, one that is reversed, in another order or tenfold from a step on is missed by more than a third.
IMPOSSIBLE_FORCES = 0.2
