"""How to extend Saltus from outside: integrators, contact solvers and model functions of one's own."""
