"""Planners: a situation in, an inspectable plan out; each takes a learned forward model and asks its tables.

api: the situation, the plan and the protocol. registry: planners by name. conformance: the check for one's own.
paper, guidance, interception, sequences, bounds: the planners that ship; search: the rollouts that planning searches.
"""
