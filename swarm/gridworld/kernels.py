"""The compiled twin of `swarm.learning`: the same rules, from the same random numbers, bit for bit.

It is fast because it keeps, for each state, the best value and the set of greedy actions (one bit an
action) and changes them when a value changes, instead of looking at eight values at every step. All
compiled functions stand in this one file, since numba's cache notices changes of that file only.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from swarm.geometry import MOVES
from swarm.gridworld.kernel_options import Real, Truth, Whole, Word, called, inlined
from swarm.gridworld.move_sets import ALL_MOVES, FIRST_MEMBER, MEMBER, SIZE
from swarm.gridworld.splitmix import FIRST, GOLDEN, SECOND
from swarm.gridworld.state import (
    ASKED,
    AVERAGE,
    COMPLETION,
    COPIED,
    FIXED,
    NO_REPLAY,
    SUGGESTED,
    SUGGESTED_AT_RANDOM,
    TRIED,
    UNLIMITED,
    WATCHES_EXPERT,
    WATCHES_NOBODY,
    AgentArrays,
    ArenaArrays,
    BestPathArrays,
    LearnerArrays,
    Limits,
    Rules,
)

# Places, actions and sets of actions are unsigned: numba would look whether a signed index is negative.
_U = np.uint64
_GOLDEN, _FIRST, _SECOND, _MOVES, _ONE = _U(GOLDEN), _U(FIRST), _U(SECOND), _U(MOVES), _U(1)


@inlined
def _mixed(word: Word) -> Word:
    """The random bits that SplitMix64 makes of its state."""
    word = (word ^ (word >> _U(30))) * _FIRST
    word = (word ^ (word >> _U(27))) * _SECOND
    return word ^ (word >> _U(31))


@inlined
def _bits(stream: NDArray[np.uint64]) -> Word:
    """`SplitMix64.bits`."""
    stream[0] += _GOLDEN
    return _mixed(stream[0])


@inlined
def _random(stream: NDArray[np.uint64]) -> Real:
    return np.float64(np.int64(_bits(stream) >> _U(11))) * 2.0**-53


@inlined
def _integer(high: Whole, bits: Word) -> Word:
    """`SplitMix64.integers`, of bits already drawn."""
    return ((bits >> _U(32)) * _U(high)) >> _U(32)


@inlined
def _member(actions: Word, bits: Word) -> Word:
    """A member of a set of actions, at random."""
    return _U(MEMBER[actions * _MOVES + _integer(SIZE[actions], bits)])


@inlined
def _has_tie(actions: Word) -> Truth:
    return actions & (actions - _ONE) != 0


@inlined
def _greedy(actions: Word, stream: NDArray[np.uint64]) -> Word:
    """`QTable.greedy`."""
    return _member(actions, _bits(stream)) if _has_tie(actions) else _U(FIRST_MEMBER[actions])


@inlined
def _explored(actions: Word, rules: Rules, bits: Word, more_bits: Word) -> Word:
    """One of the greedy actions, or any; no branch waits for a random number."""
    any_move = _integer(MOVES, more_bits)
    if actions == ALL_MOVES:
        return any_move
    best = _member(actions, more_bits) if _has_tie(actions) else _U(FIRST_MEMBER[actions])
    return any_move if bits >> _U(11) < rules.explores_below else best


@inlined
def _epsilon_greedy(agent: AgentArrays, rules: Rules) -> Word:
    """`Controller._epsilon_greedy`."""
    actions = _U(agent.greedy[agent.state[0]])
    return _explored(actions, rules, _bits(agent.stream), _bits(agent.stream))


@inlined
def _neighbour(world: ArenaArrays, state: Word, action: Word) -> Word:
    """`Grid.neighbour`, or the place itself if the move is blocked."""
    return state + world.offsets[action] if (_U(world.ways[state]) >> action) & _ONE else state


@inlined
def _ratio(agent: AgentArrays, i: Whole, approach: Whole) -> Real:
    """`ImitationMemory.ratio`."""
    if approach == FIXED:
        return 1.0
    return (agent.n_counted[i] + 1) / (agent.n_replicated[i] + 1)


@called
def _weigh(agent: AgentArrays, first: Whole, approach: Whole) -> None:
    """Bring the ratios and their running sums up to date from the path `first` on."""
    total = agent.totals[first - 1] if first > 0 else 0.0
    for i in range(first, agent.remembered[0]):
        agent.ratios[i] = _ratio(agent, i, approach)
        total += agent.ratios[i]
        agent.totals[i] = total


@inlined
def _choose_path(agent: AgentArrays) -> Whole:
    """`ImitationMemory.choose`."""
    last = agent.remembered[0] - 1
    if last == 0:
        return 0
    at = _random(agent.stream) * agent.totals[last]
    chosen = 0
    for i in range(last):
        chosen += agent.totals[i] <= at
    return chosen


@called
def remember(agent: AgentArrays, rules: Rules, moves: NDArray[np.uint8], start: Whole, length: Whole) -> None:
    """`ImitationMemory.remember` of `length` moves out of a ring that begins at `start`."""
    if agent.remembered[0] == len(agent.lengths):
        _forget(agent)
    i = agent.remembered[0]
    for k in range(length):
        agent.paths[i, k] = moves[(start + k) % len(moves)]
    agent.lengths[i], agent.n_replicated[i], agent.n_counted[i] = length, 0, 0
    agent.remembered[0] += 1
    agent.tally[COPIED] += 1
    _weigh(agent, 0, rules.approach)


@called
def _forget(agent: AgentArrays) -> None:
    lowest = 0
    for i in range(1, agent.remembered[0]):
        if agent.ratios[i] < agent.ratios[lowest]:
            lowest = i
    for i in range(lowest, agent.remembered[0] - 1):
        for k in range(agent.paths.shape[1]):
            agent.paths[i, k] = agent.paths[i + 1, k]
        agent.lengths[i] = agent.lengths[i + 1]
        agent.n_replicated[i] = agent.n_replicated[i + 1]
        agent.n_counted[i] = agent.n_counted[i + 1]
        agent.ratios[i] = agent.ratios[i + 1]
    agent.remembered[0] -= 1


@inlined
def _choose(agent: AgentArrays, other: AgentArrays, rules: Rules) -> Word:
    """`Controller.choose`."""
    last = False
    if agent.replay[0] == NO_REPLAY:
        path = _choose_path(agent)
        if rules.beta * agent.ratios[path] <= _random(agent.stream):
            return _epsilon_greedy(agent, rules)
        agent.replay[0], agent.replay_index[0], agent.q_change[0] = path, 0, 0.0
    else:
        agent.replay_index[0] += 1
        last = agent.replay_index[0] == agent.lengths[agent.replay[0]] - 1
    state = agent.state[0]
    if rules.accesses:
        suggested = _U(other.greedy[state])
        action = _greedy(suggested, agent.stream)
        agent.tally[SUGGESTED] += 1
        agent.tally[SUGGESTED_AT_RANDOM] += suggested == ALL_MOVES
    else:
        action = _U(agent.paths[agent.replay[0], agent.replay_index[0]])
    if (rules.checks_last or not last) and not (_U(agent.greedy[state]) >> action) & _ONE:
        _end(agent, rules, False)
        return _epsilon_greedy(agent, rules)
    return action


@inlined
def _end(agent: AgentArrays, rules: Rules, completed: Truth) -> None:
    """`Controller._end`."""
    path = agent.replay[0]
    agent.tally[TRIED] += agent.n_replicated[path] == 0
    agent.n_replicated[path] += 1
    agent.n_counted[path] += completed if rules.approach == COMPLETION else agent.q_change[0] > 0.0
    _weigh(agent, path, rules.approach)
    agent.replay[0] = NO_REPLAY


@inlined
def _update(
    agent: AgentArrays, rules: Rules, state: Word, action: Word, reward: Real, next_state: Word
) -> Real:
    """`QTable.update`, and the set of greedy actions with it; return `Controller._counted`."""
    at = state * _MOVES + action
    old = agent.q[at]
    change = rules.alpha * (reward + rules.gamma * agent.best[next_state] - old)
    agent.q[at] = old + change
    value = agent.q[at]
    best, actions, this = agent.best[state], _U(agent.greedy[state]), _ONE << action
    joined = actions | this if value == best else actions & ~this
    actions = this if value > best else joined
    best = max(value, best)
    if actions == 0:
        best, actions = _scan(agent.q, state)
    agent.best[state], agent.greedy[state] = best, actions
    return change if rules.increase == ASKED else _moved(agent, rules, value - old)


@inlined
def _moved(agent: AgentArrays, rules: Rules, stored: Real) -> Real:
    """How far a value has moved, or the sum of them all."""
    if rules.increase != AVERAGE:
        return stored
    total = agent.q_total[0]
    agent.q_total[0] = total + stored
    return agent.q_total[0] - total


@called
def _scan(q: NDArray[np.float64], state: Word) -> tuple[Real, Word]:
    """The best value of a state and the set of actions that have it."""
    best, actions = q[state * _MOVES], _ONE
    for action in range(1, MOVES):
        value, this = q[state * _MOVES + _U(action)], _ONE << _U(action)
        if value > best:
            best, actions = value, this
        elif value == best:
            actions |= this
    return best, actions


@called
def prepare(agent: AgentArrays) -> None:
    """Find the best values and greedy sets of a table that was filled from outside."""
    for state in range(len(agent.best)):
        agent.best[state], agent.greedy[state] = _scan(agent.q, _U(state))


@inlined
def step(world: ArenaArrays, agent: AgentArrays, other: AgentArrays, rules: Rules) -> Truth:
    """Choose, move and learn once; whether the goal was reached, and the agent put back to the start."""
    imitates = agent.remembered[0] > 0
    action = _choose(agent, other, rules) if imitates else _epsilon_greedy(agent, rules)
    state = agent.state[0]
    next_state = _neighbour(world, state, action)
    arrived = next_state == world.goal
    change = _update(agent, rules, state, action, 1.0 if arrived else 0.0, next_state)
    if imitates and agent.replay[0] != NO_REPLAY:
        agent.q_change[0] += change
        completed = agent.replay_index[0] == agent.lengths[agent.replay[0]] - 1
        if completed or arrived or next_state == state:
            _end(agent, rules, completed)
    if rules.seen:
        _leave_trail(agent, action, arrived)
    agent.state[0] = world.start if arrived else next_state
    agent.arrivals[0] += arrived
    return arrived


@called
def _leave_trail(agent: AgentArrays, action: Word, arrived: Truth) -> None:
    ring = len(agent.trail)
    agent.trail[agent.trail_moves[0] % ring] = action
    agent.trail_moves[0] += 1
    if arrived:
        for k in range(ring):
            agent.shown[k] = agent.trail[k]
        agent.shown_moves[0], agent.trail_moves[0] = agent.trail_moves[0], 0


@called
def copy_moves(world: ArenaArrays, one: LearnerArrays, two: LearnerArrays) -> None:
    """`one` sees a stretch of its teacher's trajectory and remembers it.

    Of another agent these are its last moves, all of one run: the agents' runs are out of step, so
    they come from a random place of its trajectory.
    """
    agent, other, rules = one.agent, two.agent, one.rules
    if rules.watches == WATCHES_EXPERT:
        places = len(world.expert_path) - rules.moves + 1
        start = np.int64(_integer(places, _bits(agent.watching)))
        remember(agent, rules, world.expert_path, start, rules.moves)
        return
    ring, moves = other.trail, other.trail_moves[0]
    if moves < rules.moves and other.shown_moves[0] > moves:
        ring, moves = other.shown, other.shown_moves[0]
    length = min(moves, rules.moves)
    remember(agent, rules, ring, moves - length, length)


@inlined
def _step_and_copy(world: ArenaArrays, one: LearnerArrays, two: LearnerArrays) -> None:
    arrived = step(world, one.agent, two.agent, one.rules)
    watches = one.rules.watches != WATCHES_NOBODY
    if arrived and watches and one.agent.arrivals[0] % one.rules.every == 0:
        copy_moves(world, one, two)


@called
def best_path_length(world: ArenaArrays, agent: AgentArrays, found: BestPathArrays) -> Whole:
    """`greedy_path_length`; not walked again while every set that the last path rests on is the same."""
    length = found.length[0]
    unchanged = length > 0
    for k in range(length):
        unchanged &= agent.greedy[found.route[k]] == found.sets[k]
    if unchanged:
        return length
    return _walk(world, agent, found)


@called
def _walk(world: ArenaArrays, agent: AgentArrays, found: BestPathArrays) -> Whole:
    state, ties, luck, length = world.start, False, False, 0
    while state != world.goal and length < len(found.route):
        actions = _U(agent.greedy[state])
        found.route[length], found.sets[length] = state, actions
        ties |= _has_tie(actions)
        luck |= actions == ALL_MOVES
        state = _neighbour(world, state, _greedy(actions, found.stream))
        length += 1
    found.length[0] = 0 if ties else length
    return len(found.route) if luck and not found.counts_luck else length


@called
def _evaluate(world: ArenaArrays, learner: LearnerArrays, point: Whole) -> None:
    if point < len(learner.found.lengths):
        learner.found.lengths[point] = best_path_length(world, learner.agent, learner.found)


@inlined
def _practise(world: ArenaArrays, agent: AgentArrays, rules: Rules, steps: Whole, reachings: Whole) -> Whole:
    """`step` for an agent alone with an empty memory, many times, its state kept in registers."""
    state, word = agent.state[0], agent.stream[0]
    taken: Whole = 0
    while taken < steps and agent.arrivals[0] < reachings:
        bits, more_bits = _mixed(word + _GOLDEN), _mixed(word + _GOLDEN + _GOLDEN)
        word += _GOLDEN + _GOLDEN
        action = _explored(_U(agent.greedy[state]), rules, bits, more_bits)
        next_state = _neighbour(world, state, action)
        arrived = next_state == world.goal
        _update(agent, rules, state, action, 1.0 if arrived else 0.0, next_state)
        state = world.start if arrived else next_state
        agent.arrivals[0] += arrived
        taken += 1
    agent.state[0], agent.stream[0] = state, word
    return taken


@called
def run(world: ArenaArrays, one: LearnerArrays, two: LearnerArrays, limits: Limits) -> Whole:
    """Let `one`, and in turn `two` if it takes part, act until a limit; return the steps taken.

    The best paths are looked for every `limits.every` steps while there is room for them.
    """
    agent, rules, points = one.agent, one.rules, len(one.found.lengths)
    watches = rules.watches != WATCHES_NOBODY
    alone = not watches and not rules.seen and agent.remembered[0] == 0
    point, due = 0, limits.every
    taken: Whole = 0
    while taken < limits.steps and agent.arrivals[0] < limits.reachings:
        if alone:
            made = _practise(world, agent, rules, min(due, limits.steps) - taken, limits.reachings)
            if limits.pair:
                _practise(world, two.agent, two.rules, made, UNLIMITED)
            taken += made
        else:
            _step_and_copy(world, one, two)
            if limits.pair:
                _step_and_copy(world, two, one)
            taken += 1
        if taken == due:
            _evaluate(world, one, point)
            _evaluate(world, two, point)
            point += 1
            every = limits.every if point < limits.points else limits.later_every
            due = due + every if point < points else limits.steps + 1
    return taken
