/* Boots the page of one hunt, or of more that go in step: the longest leads. */
(() => {
  const roots = [...document.querySelectorAll("[data-player]")];
  const hunts = [...document.querySelectorAll("[data-hunt-data]")].map((node) => JSON.parse(node.textContent));
  const ends = hunts.map((hunt) => hunt.trail.time[hunt.trail.time.length - 1]);
  const first = ends.indexOf(Math.max(...ends));
  const followers = roots.map((root, i) => (i === first ? null : new Player(root, null)));
  const leader = new Player(roots[first], document, followers.filter(Boolean));
  roots.forEach((root, i) => root.classList.toggle("follower", i !== first));
  leader.duration = ends[first];
  followers.forEach((player, i) => player && player.load(hunts[i]));
  leader.load(hunts[first]);
  const follow = () => {
    const asked = /[#&]d=(\d+)/.exec(location.hash);
    if (asked) leader.toDecision(Number(asked[1]));
  };
  follow();
  leader.decided = (number) => history.replaceState(null, "", `#d=${number}`);
  addEventListener("hashchange", follow);
})();
