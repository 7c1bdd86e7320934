// Puts the page together, and follows links to a moment: #at=<set>/<clip>/<frame>.

const charts = all(".charts").flatMap((place) => {
  const [set, name] = place.dataset.chart.split("/");
  const panels = data.charts[set][name].map((panel) => new Chart(panel));
  place.classList.add(["one", "two"][panels.length - 1] ?? "many");
  place.prepend(...panels.map((chart) => chart.element));
  panels.forEach((chart) => chart.draw());
  return panels;
});
all("table.sortable").forEach(sortable);
new Filters(document.querySelector(".filters"), charts);

const players = Object.fromEntries(all(".player").map((element) => {
  const player = new Player(element, data.films[element.dataset.film]);
  new Controls(player);
  player.open(0);
  return [element.dataset.film, player];
}));

function goTo(hash) {
  const [set, clip, frame] = hash.slice("#at=".length).split("/").map(decodeURIComponent);
  const player = players[set];
  if (!player?.seek(clip, Number(frame))) return;
  player.element.scrollIntoView({ block: "center" });
  player.element.focus({ preventScroll: true });
}

document.addEventListener("click", (event) => {
  const link = event.target.closest("a[href^='#at=']");
  if (link && link.hash === location.hash) goTo(link.hash); // the address stays, so nothing else would happen
});
addEventListener("hashchange", () => location.hash.startsWith("#at=") && goTo(location.hash));
if (location.hash.startsWith("#at=")) goTo(location.hash);
document.documentElement.dataset.started = "yes";
