// Which data sets and models the page shows; tables, charts and sections all follow.

class Filters {
  constructor(form, charts) {
    Object.assign(this, { form, charts });
    this.choices = form.querySelector(".choices");
    const known = [...all("[data-model]").map((row) => row.dataset.model), ...charts.flatMap((chart) => chart.panel.lines.map((line) => line.model))];
    for (const kind of ["tracker", "predictor"]) this.offer(kind, [...new Set(known)].filter((model) => model.startsWith(`${kind}:`)));
    form.hidden = false;
    form.addEventListener("change", () => this.apply());
    form.addEventListener("submit", (event) => event.preventDefault());
    document.addEventListener("click", (event) => form.contains(event.target) || this.close());
    form.addEventListener("keydown", (event) => event.key === "Escape" && this.close());
  }

  offer(kind, models) {
    if (models.length === 0) return;
    const boxes = models.map((model) => `<label><input type="checkbox" name="model" value="${escaped(model)}" checked> ${escaped(model.slice(kind.length + 1).replaceAll("_", " "))}</label>`);
    const part = made(`<fieldset><legend>${kind}s</legend><p><button type="button">all</button> <button type="button">none</button></p>${boxes.join("")}</fieldset>`);
    all("button", part).forEach((button, number) => button.addEventListener("click", () => {
      all("input", part).forEach((box) => (box.checked = number === 0));
      this.apply();
    }));
    this.choices.append(part);
  }

  close() {
    const details = this.form.querySelector("details");
    if (details.open && details.contains(document.activeElement)) details.querySelector("summary").focus();
    details.open = false;
  }

  chosen(name) {
    const boxes = all(`[name=${name}]`, this.form);
    return { of: boxes.length, values: new Set(boxes.filter((box) => box.checked).map((box) => box.value)) };
  }

  apply() {
    const [sets, models] = [this.chosen("set"), this.chosen("model")];
    for (const element of all("[data-set], [data-model]")) {
      const { set, model } = element.dataset;
      element.hidden = (set !== undefined && !sets.values.has(set)) || (model !== undefined && !models.values.has(model));
    }
    for (const chart of this.charts) chart.filter((model) => models.values.has(model));
    for (const figure of all(".charts")) figure.hidden = all(".chart", figure).every((chart) => chart.hidden);
    this.form.querySelector("output").value = models.values.size === models.of ? "all" : `${models.values.size} of ${models.of}`;
  }
}
