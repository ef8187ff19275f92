"""The figures of Ghanbarzadeh, Hassanpour and Neville (2019), computed and judged."""
